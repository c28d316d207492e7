/* Runs an exported loop over many readings. Actions: 1 resets, 2 forgets what was integrated. */
#include "loop.h"

void replay(int64_t count, const loop_reading *readings, const uint8_t *actions,
            loop_command *commands, loop_memory *memory);

int64_t memory_size(void) { return (int64_t)sizeof(loop_memory); }

void replay(int64_t count, const loop_reading *readings, const uint8_t *actions,
            loop_command *commands, loop_memory *memory) {
    for (int64_t k = 0; k < count; k++) {
        if (actions[k] == 1) {
            loop_reset(memory);
        }
        if (actions[k] == 2) {
            loop_forget_integrals(memory);
        }
        loop_step(memory, &readings[k], &commands[k]);
    }
}
