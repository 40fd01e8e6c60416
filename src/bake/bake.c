#include <octalux/bake.h>
