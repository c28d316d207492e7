#include "furuta_encoder.h"

/* Counts from levels (2 A + B) before to levels after, at index 4 · before + after. 0 where both
   channels changed: the direction is unknown then. */
static const int8_t moves[16] = {0, -1, 1, 0, 1, 0, 0, -1, -1, 0, 0, 1, 0, 1, -1, 0};

void furuta_encoder_move(volatile struct furuta_encoder *encoder, bool a, bool b) {
    const uint8_t levels = (uint8_t)((a ? 2u : 0u) | (b ? 1u : 0u));
    const uint8_t before = encoder->levels;
    encoder->count += moves[(4u * before) + levels];
    encoder->levels = levels;
}
