/* The firmware's core as it is, in one translation unit, so that its static parts can be reached. */
#include "furuta_firmware.c"
#include "furuta_frames.c"
#include "furuta_rig.c"

#include "core.h"

struct furuta_rig *const core_rig = &rig;
struct furuta_sample *const core_newest = &newest;
struct furuta_reader *const core_reader = &reader;
bool *const core_unsent = &unsent, *const core_ticked = &ticked;
