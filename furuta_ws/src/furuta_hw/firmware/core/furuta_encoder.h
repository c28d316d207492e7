/* A quadrature encoder, decoded at every edge of both channels: four counts per line. */
#ifndef FURUTA_ENCODER_H
#define FURUTA_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All zero at the start; call furuta_encoder_move once, then set count to 0. */
struct furuta_encoder {
    int32_t count;
    uint8_t levels;
};

/* Takes the levels of both channels after an edge. The count grows while A leads B. */
void furuta_encoder_move(volatile struct furuta_encoder *encoder, bool a, bool b);

#ifdef __cplusplus
}
#endif

#endif
