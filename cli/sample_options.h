// The options for sampling a field that `render`, `audit` and `view` share.
#ifndef OCTALUX_CLI_SAMPLE_OPTIONS_H
#define OCTALUX_CLI_SAMPLE_OPTIONS_H

#include "options.h"

// Options that fill an olx_sample_settings.
extern const option sample_options[];

#endif
