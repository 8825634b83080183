/* The one compilation unit of an FMU. Everything but the FMI functions is static, so that no
 * symbol meets another FMU's, whether the units are linked statically or loaded. */

#include "model.c" /* generated from the plant's equations; defines FMI_VERSION */

#include "rodas5p.c"

#include "component.c"

#if FMI_VERSION == 3
#include "fmi3.c"
#else
#include "fmi2.c"
#endif
