// The runtime of Octalux: everything with which a program lights its pictures from a baked field on the CPU.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_OCTALUX_H
#define OCTALUX_OCTALUX_H

#include <octalux/base.h>
#include <octalux/denoiser.h>
#include <octalux/field.h>
#include <octalux/sample.h>
#include <octalux/relight.h>

#endif
