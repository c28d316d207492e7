/* Generated with loop.h, which says from what. Integers have 64 bits, as in the original. */
#include "loop.h"

@preamble@
@constants@

@functions@

void loop_init(loop_memory *memory) {
    const loop_memory zero = {0};
    *memory = zero;@initial@
}

void loop_step(loop_memory *memory, const loop_reading *reading, loop_command *command) {
    @real@ measurement[5] = {
        reading->phi, reading->phi_dot, reading->theta, reading->theta_dot, reading->torque,
    };
    const @step@_result result = @step@(memory, measurement, command->estimate);
    command->friction = result.part0;
    command->voltage = result.part1;
}

void loop_reset(loop_memory *memory) {
    @reset@(memory);
}

void loop_forget_integrals(loop_memory *memory) {
    @forget_integrals@(&memory->controller);
}
