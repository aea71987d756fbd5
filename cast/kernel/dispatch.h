/* dispatch.h - one function compiled for several processors; the loader picks what the machine has.
 * Elsewhere than on x86-64 Linux with gcc the function is compiled once. DISPATCH_X86: functions may be written for a
 * target and chosen by __builtin_cpu_supports. With SIMD_ONE_FORM defined there are no clones: a test compares forms.
 */
#ifndef CAST_KERNEL_DISPATCH_H
#define CAST_KERNEL_DISPATCH_H

#include <stdint.h> // any header of the C library tells whether it is glibc, whose loader does the picking

#if !defined(SIMD_ONE_FORM) && defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && defined(__GNUC__) && \
    !defined(__clang__)
#define SIMD_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SIMD_CLONES
#endif

#if defined(__x86_64__) && defined(__GNUC__)
#define DISPATCH_X86
#endif

#endif
