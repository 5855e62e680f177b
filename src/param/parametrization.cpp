#include "knotreel/param/parametrization.h"
