/* Generated with loop.h, which says from what. Integers have 64 bits, as in the original. */
#include "loop.h"

#if defined(__FAST_MATH__)
#error "compile without fast-math: NAN marks what is not known"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif

#if __STDC_HOSTED__
#include <math.h>
#else /* the compiler's own */
#define NAN __builtin_nanf("")
#define isnan(x) __builtin_isnan(x)
#define copysign@s@ __builtin_copysign@s@
#define fabs@s@ __builtin_fabs@s@
#define floor@s@ __builtin_floor@s@
#define fma@s@ __builtin_fma@s@
#define sqrt@s@ __builtin_sqrt@s@
#endif

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
