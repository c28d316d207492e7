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

/* Both functions below take the torque that the drive has applied since the sample before, NAN if
 * it is not known, and a position that is NAN where it is missing, but not in the first sample. */

/* Prepare for the first sample. */
void axis_init(axis_memory *memory);

/* Prepare for a sample that does not continue the ones before. What has been learned is kept, and
 * memory->integral, the torque of the controller's integral; set it to 0 while commands are not applied. */
void axis_reset(axis_memory *memory);

@controller@
@real@ axis_step(axis_memory *memory, @real@ position, @real@ torque, @real@ reference,
                 @real@ reference_speed);

/* Instead of axis_step, for another controller: the friction estimate, to be added to its command.
 * speed counts only without an inertia. reference_speed is NAN without a reference. */
@real@ axis_friction(axis_memory *memory, @real@ position, @real@ speed, @real@ torque,
                     @real@ reference_speed);

#ifdef __cplusplus
}
#endif

#endif
