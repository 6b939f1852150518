# Settings of all targets of Weft: C++20, the include path of the sources, warnings as errors, and arithmetic with the same
# bits everywhere.

function(weft_target target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_BINARY_DIR}/generated)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:Eigen3::Eigen>)
  # Where Eigen has vectors of doubles (SSE2, NEON), it sums dot() and norm() in another order than where it has none. The
  # other name keeps a program's own copies of its inline functions, compiled with other settings, apart.
  target_compile_definitions(${target} PRIVATE EIGEN_DONT_VECTORIZE Eigen=weft_Eigen)
  if(MSVC)
    target_compile_options(${target} PRIVATE /W4 /WX /fp:precise)
  else()
    # Fused multiply-adds would make the result depend on the machine. The other two let loops with square roots
    # be vectorised; neither changes a result.
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wno-missing-field-initializers -Werror
                                             -ffp-contract=off -fno-math-errno -fno-trapping-math)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)  # false alarms on std::string, GCC bug 105651
  endif()
  weft_sanitize(${target})
endfunction()

# Precompiles headers of others that most sources of a target include, and `ARGN` besides: a third of the compile time.
function(weft_precompile target)
  if(WEFT_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE <Eigen/Geometry> <algorithm> <array> <filesystem> <functional> <map>
                                                <memory> <optional> <span> <string> <variant> <vector> ${ARGN})
    weft_allow_precompiled(${target})
  endif()
endfunction()

# GCC's optimiser warns of code in precompiled headers as if it were not of others: false alarms, GCC bug 105651.
function(weft_allow_precompiled target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-restrict
                                             -Wno-maybe-uninitialized -Wno-nonnull -Wno-free-nonheap-object)
  endif()
endfunction()

# The sanitizers of WEFT_SANITIZE, if any.
function(weft_sanitize target)
  if(WEFT_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${WEFT_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${WEFT_SANITIZE})
    if(WEFT_SANITIZE MATCHES undefined)  # checks of every pointer, which take a third of the compile time
      target_compile_options(${target} PRIVATE -fno-sanitize=null,alignment,object-size,vptr,nonnull-attribute)
    endif()
    # Instrumentation by the sanitizers causes false warnings: loops that are not vectorised (clang), and variables of
    # std::regex that seem uninitialised (GCC bug 105562).
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:Clang,AppleClang>:-Wno-pass-failed>
                                             $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    get_target_property(type ${target} TYPE)
    if(WEFT_SANITIZE MATCHES address AND type STREQUAL "EXECUTABLE")
      target_sources(${target} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/keep_loaded.cpp)
    endif()
  endif()
endfunction()
