@about@
#ifndef FURUTA_LOOP_H
#define FURUTA_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#define LOOP_REAL @real@

/* Time between two calls of loop_step [s]. */
#define LOOP_SAMPLE_TIME @sample_time@

/* Calibration of the rig: value = (code - zero) * per_code [rad, rad/s, rad, V]. */
@calibration@

/* What the sensors say; NAN where a reading is missing or there is no sensor. */
typedef struct {
    @real@ phi;       /* arm angle [rad] */
    @real@ phi_dot;   /* arm speed [rad/s] */
    @real@ theta;     /* pendulum angle, 0 upright [rad] */
    @real@ theta_dot; /* pendulum speed [rad/s], NAN unless all sensors are ideal */
    @real@ torque;    /* voltage that the drive has applied since the reading before [V] */
} loop_reading;

/* The command, and what it was computed from. */
typedef struct {
    @real@ voltage;     /* command u [V] */
    @real@ friction;    /* friction estimate [V] */
    @real@ estimate[5]; /* phi, phi_dot, theta, theta_dot, observed friction; NAN if unknown */
} loop_command;

@structures@

/* All that the loop remembers. */
typedef @memory@ loop_memory;

#ifdef __cplusplus
extern "C" {
#endif

/* Prepare for the first reading. */
void loop_init(loop_memory *memory);

/* One sample: the command for a reading. */
void loop_step(loop_memory *memory, const loop_reading *reading, loop_command *command);

/* Prepare for a reading that does not continue the ones before; what has been learned is kept. */
void loop_reset(loop_memory *memory);

/* Call it before loop_step while commands are not applied: nothing is integrated meanwhile. */
void loop_forget_integrals(loop_memory *memory);

#ifdef __cplusplus
}
#endif

#endif
