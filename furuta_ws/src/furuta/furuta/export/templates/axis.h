@about@
#ifndef FURUTA_AXIS_H
#define FURUTA_AXIS_H

#include <stdbool.h>
#include <stdint.h>

#define AXIS_REAL @real@

/* Time between two calls [s]. */
#define AXIS_SAMPLE_TIME @sample_time@

@structures@

/* All that is remembered. */
typedef @memory@ axis_memory;

#ifdef __cplusplus
extern "C" {
#endif

/* Prepare for the first sample. */
void axis_init(axis_memory *memory);

/* Prepare for a sample that does not continue the ones before. */
void axis_reset(axis_memory *memory);

@controller@
@real@ axis_step(axis_memory *memory, @real@ position, @real@ torque, @real@ reference,
                 @real@ reference_speed);

/* Instead of axis_step, for another controller: the friction estimate, to be added to its command.
 * NAN where there is no torque or no reference. speed counts only without an inertia. */
@real@ axis_friction(axis_memory *memory, @real@ position, @real@ speed, @real@ torque,
                     @real@ reference_speed);

#ifdef __cplusplus
}
#endif

#endif
