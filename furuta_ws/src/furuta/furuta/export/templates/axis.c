/* Generated with axis.h, which says from what. Integers have 64 bits, as in the original. */
#include "axis.h"

@preamble@

@constants@

@functions@

void axis_init(axis_memory *memory) {
    const axis_memory zero = {0};
    *memory = zero;@initial@
}

void axis_reset(axis_memory *memory) {
    @reset@;
}

@real@ axis_step(axis_memory *memory, @real@ position, @real@ torque, @real@ reference,
                 @real@ reference_speed) {
@unused_by_step@    return @step@;
}

@real@ axis_friction(axis_memory *memory, @real@ position, @real@ speed, @real@ torque,
                     @real@ reference_speed) {
@unused_by_friction@    return @friction@;
}
