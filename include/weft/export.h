#pragma once
/// Macros of public declarations: symbols that a shared library exports, and deprecated ones.

#if defined(_WIN32)
#define WEFT_API  // Windows: static library only
#else
#define WEFT_API __attribute__((visibility("default")))
#endif

#define WEFT_DEPRECATED(successor) [[deprecated("use " successor)]]
