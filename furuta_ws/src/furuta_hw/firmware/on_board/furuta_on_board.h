/* The loop on the board: an exported control system answers each sample in the timer's interrupt.
   Only for firmware that is compiled with FURUTA_ON_BOARD. docs/export.md says how. */
#ifndef FURUTA_ON_BOARD_H
#define FURUTA_ON_BOARD_H

#include "furuta_rig.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The Drive frame that answers a sample. */
struct furuta_frame furuta_answer(const struct furuta_sample *sample);

#ifdef __cplusplus
}
#endif

#endif
