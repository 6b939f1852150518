#pragma once
/// Marks of public declarations: what a shared library exports, and what is deprecated.

#if defined(_WIN32)
#define WEFT_API  // Windows: static library only
#else
#define WEFT_API __attribute__((visibility("default")))
#endif

#define WEFT_DEPRECATED(successor) [[deprecated("use " successor)]]
