#pragma once

// KNOTREEL_MULTIVERSION before a function with plain loops compiles it for several x86-64 levels and picks
// one at program start, so that one binary uses wide vectors where they exist. Without fused multiply-add
// (see cmake/compiler.cmake) all versions give the same bits. Sanitizers start too late for the resolvers.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define KNOTREEL_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define KNOTREEL_MULTIVERSION
#endif
