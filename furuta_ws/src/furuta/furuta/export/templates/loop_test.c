/* Replays a simulated run with the sensors' noise and a push, and compares the commands.
 * Prints the largest deviation; the exit status is 1 if it is above the tolerance. */
#include <math.h>
#include <stdio.h>

#include "loop.h"

/* phi [rad], phi_dot [rad/s], theta [rad], theta_dot [rad/s], torque [V] */
static const @real@ readings[@samples@][5] = {
@readings@
};

/* Command and friction estimate as the simulation computed them, in double [V]. */
static const double expected[@samples@][2] = {
@expected@
};

int main(void) {
    const double tolerance = @tolerance@;
    double largest = 0.0;
    loop_memory memory;
    loop_init(&memory);
    for (int k = 0; k < @samples@; k++) {
        const @real@ *r = readings[k];
        const loop_reading reading = {r[0], r[1], r[2], r[3], r[4]};
        loop_command command;
        loop_step(&memory, &reading, &command);
        largest = fmax(largest, fabs((double)command.voltage - expected[k][0]));
        largest = fmax(largest, fabs((double)command.friction - expected[k][1]));
    }
    printf("largest deviation in @samples@ samples: %g V\n", largest);
    return largest > tolerance;
}
