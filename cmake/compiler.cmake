set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

find_program(KNOTREEL_CCACHE ccache)
if(KNOTREEL_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache is told that precompiled headers may be trusted; without, it does not cache what uses them. That it takes what
  # a source depends on from the compiler saves it a run of the preprocessor for each source that is not in the cache.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_DEPEND=1 ${KNOTREEL_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-fpch-preprocess)
  endif()
endif()

# Target that every module links: flags only.
add_library(knotreel_flags INTERFACE)
target_compile_options(knotreel_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  # The same document gives the same bits on every machine: no fused multiply-add unless written so.
  -ffp-contract=off
  # Nobody asks for errno or floating-point exceptions; loops become vectors without them, with the same values.
  -fno-math-errno -fno-trapping-math)
# g++ 12 sees an overlap in every `"text" + std::string` (GCC bug 105651), and reads past the end of every copied
# Boost small_vector.
target_compile_options(knotreel_flags INTERFACE
  "$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-stringop-overread>")
if(KNOTREEL_WERROR)
  target_compile_options(knotreel_flags INTERFACE -Werror)
endif()
if(KNOTREEL_SANITIZE)
  target_compile_options(knotreel_flags INTERFACE
    -fsanitize=${KNOTREEL_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(knotreel_flags INTERFACE -fsanitize=${KNOTREEL_SANITIZE})
  # With the address sanitizer a null pointer or an object too small ends the program where it is used; to be told where
  # the pointer or the reference is made takes g++ as long as all the rest.
  if(KNOTREEL_SANITIZE MATCHES "address" AND KNOTREEL_SANITIZE MATCHES "undefined" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(knotreel_flags INTERFACE -fno-sanitize=null,object-size)
  endif()
  target_compile_definitions(knotreel_flags INTERFACE KNOTREEL_CHECKED)
endif()
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
  target_compile_definitions(knotreel_flags INTERFACE KNOTREEL_CHECKED)
endif()
