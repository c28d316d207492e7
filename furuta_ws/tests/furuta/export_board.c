/* Links an exported loop without a C library. */
#include "loop.h"

void board_start(loop_memory *memory, const loop_reading *reading, loop_command *command);
void __aeabi_memclr8(unsigned char *to, unsigned long count);

void board_start(loop_memory *memory, const loop_reading *reading, loop_command *command) {
    loop_init(memory);
    loop_step(memory, reading, command);
}

void __aeabi_memclr8(unsigned char *to, unsigned long count) {
    for (volatile unsigned char *at = to; at < to + count; at++) {
        *at = 0;
    }
}
