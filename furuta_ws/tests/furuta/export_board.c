/* Links an exported loop without a C library. */
#include "loop.h"

void board_start(loop_memory *memory, const loop_reading *reading, loop_command *command);

void board_start(loop_memory *memory, const loop_reading *reading, loop_command *command) {
    loop_init(memory);
    loop_step(memory, reading, command);
}
