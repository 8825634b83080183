/* The one compilation unit of a block's FMU. Everything but the FMI functions is static; the step
 * function comes as an object file, hidden inside the shared library. */

#include "model.c" /* generated from the block's interface; defines FMI_VERSION */

#include "block.c"

#if FMI_VERSION == 3
#include "fmi3.c"
#else
#include "fmi2.c"
#endif
