#pragma once
/// Version of the library, and its compatibility.
///
/// A program that compiles with 0.x compiles with every later patch of the same 0.x. A declaration due for
/// removal is marked WEFT_DEPRECATED with its successor for one minor version; the next one removes it. The
/// layout of types may change with every version: recompile.

#define WEFT_VERSION_MAJOR 0
#define WEFT_VERSION_MINOR 1
#define WEFT_VERSION_PATCH 0

/// For comparisons: WEFT_VERSION >= 100 is 0.1.0 or later.
#define WEFT_VERSION (WEFT_VERSION_MAJOR * 10000 + WEFT_VERSION_MINOR * 100 + WEFT_VERSION_PATCH)
