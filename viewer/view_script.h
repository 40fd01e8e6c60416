// A script replaces a user's input, frame by frame: for tests and films. Lines of words; '#' begins a comment.
//
//   press KEY          W, 1, TAB, ...          look X Y     drag the mouse by so many pixels
//   hold KEY N         for N frames            pick X Y     click on a pixel
//   frames N           let N frames pass       wheel N      faster or slower
//   resize WxH         0x0 is a minimised window
//   screenshot FILE    of the next frame
//   light N X Y Z      moves light number N of the scene there; a sun shines in that direction
//   dim N FACTOR       sets light number N to FACTOR times its strength in the scene
//   quit
#ifndef OCTALUX_VIEW_SCRIPT_H
#define OCTALUX_VIEW_SCRIPT_H

#include "view_input.h"

typedef struct view_script view_script;

// Requests of a script to the program.
typedef struct view_script_wishes {
  bool resize, quit;
  uint32_t size[2];
  const char *screenshot; // NULL: none; owned by the script
} view_script_wishes;

// Reads a whole script. Returns NULL, with one line on standard error that names file and line, when it cannot be read
// or has an invalid line. The caller frees it.
view_script *view_script_open(const char *path);
void view_script_free(view_script *script); // NULL is allowed

// Pushes the events before the next frame of an image of width x height pixels. Returns false once the script is over.
bool view_script_step(view_script *script, const uint32_t size[2], view_input *input, view_script_wishes *wishes);

#endif
