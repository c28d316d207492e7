/* Compares @samples@ samples with what the original computed in double.
 * Prints the largest deviation; the exit status is 1 if it is above the tolerance. */
#include <math.h>
#include <stdio.h>

#include "axis.h"

/* Position, torque, reference and its speed. */
static const @real@ given[@samples@][4] = {
@given@
};

static const double expected[@samples@] = {
@expected@
};

int main(void) {
    const double tolerance = @tolerance@;
    double largest = 0.0;
    axis_memory memory;
    axis_init(&memory);
    for (int k = 0; k < @samples@; k++) {
        const @real@ *r = given[k];
        const @real@ computed = axis_step(&memory, r[0], r[1], r[2], r[3]);
        largest = fmax(largest, fabs((double)computed - expected[k]));
    }
    printf("largest deviation in @samples@ samples: %g\n", largest);
    return largest > tolerance;
}
