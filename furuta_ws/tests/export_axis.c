/* Calls an exported axis with pointers, without a C library. */
#include "axis.h"

int64_t memory_size(void) { return (int64_t)sizeof(axis_memory); }

/* Given: position, speed, torque, reference and its speed. */
void call_step(axis_memory *memory, const AXIS_REAL given[5], AXIS_REAL *command);
void call_friction(axis_memory *memory, const AXIS_REAL given[5], AXIS_REAL *friction);

void call_step(axis_memory *memory, const AXIS_REAL given[5], AXIS_REAL *command) {
    *command = axis_step(memory, given[0], given[2], given[3], given[4]);
}

void call_friction(axis_memory *memory, const AXIS_REAL given[5], AXIS_REAL *friction) {
    *friction = axis_friction(memory, given[0], given[1], given[2], given[4]);
}
