/* Compares @samples@ samples with what the original computed in double.
 * Prints the largest deviation; the exit status is 1 if it is above the tolerance. */
#include <math.h>
#include <stdio.h>

#include "axis.h"

/* Position, speed, torque, reference and its speed. */
static const @real@ given[@samples@][5] = {
@given@
};

/* Command of axis_step and friction estimate of axis_friction. */
static const double expected[@samples@][2] = {
@expected@
};

int main(void) {
    const double tolerance = @tolerance@;
    double largest = 0.0;
    axis_memory of_step, of_friction;
    axis_init(&of_step);
    axis_init(&of_friction);
    for (int k = 0; k < @samples@; k++) {
        const @real@ *r = given[k];
        const @real@ command = axis_step(&of_step, r[0], r[2], r[3], r[4]);
        const @real@ friction = axis_friction(&of_friction, r[0], r[1], r[2], r[4]);
        largest = fmax(largest, fabs((double)command - expected[k][0]));
        largest = fmax(largest, fabs((double)friction - expected[k][1]));
    }
    printf("largest deviation in @samples@ samples: %g\n", largest);
    return largest > tolerance;
}
