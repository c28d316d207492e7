/* Replays a script from standard input on the emulated board; the log goes to standard output.
   Under a sanitizer this ends with another status than 0 where the firmware is wrong. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

uint32_t emulated_replay(const uint8_t *begin, uint32_t size, uint8_t *log);

enum { SCRIPT_SIZE = 1 << 18, LOG_FACTOR = 64 };

int main(void) {
    uint8_t *script = malloc(SCRIPT_SIZE);
    uint8_t *log = malloc((size_t)SCRIPT_SIZE * LOG_FACTOR);
    if (script == NULL || log == NULL) {
        return 2;
    }
    const size_t size = fread(script, 1, SCRIPT_SIZE, stdin);
    const uint32_t written = emulated_replay(script, (uint32_t)size, log);
    const size_t sent = fwrite(log, 1, written, stdout);
    free(log);
    free(script);
    return sent == written ? 0 : 2;
}
