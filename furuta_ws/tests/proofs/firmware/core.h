/* Access to the firmware's static memory and functions. */
#ifndef CORE_H
#define CORE_H

#include "furuta_firmware.h"

extern struct furuta_rig *const core_rig;
extern struct furuta_sample *const core_newest;
extern struct furuta_reader *const core_reader;
extern bool *const core_unsent, *const core_ticked;

#endif
