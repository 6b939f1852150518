// For the leak sanitizer: libraries stay loaded to the end of the process. Mesa's driver holds on to a few
// blocks of memory, and only it knows where they are: when it is unloaded, with the last EGL context, they look
// lost. Any program that draws one triangle shows it.

#include <dlfcn.h>

int dlclose(void*) noexcept { return 0; }
