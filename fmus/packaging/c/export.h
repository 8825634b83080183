/* How FMI functions are named and made visible. In a static library each carries the model
 * identifier as a prefix; a shared library shows the plain names, and only those. Whoever builds
 * a shared library from these sources defines FMI_OVERRIDE_FUNCTION_PREFIX of the version. */
#ifndef EXPORT_H
#define EXPORT_H

#if defined(FMI2_OVERRIDE_FUNCTION_PREFIX) || defined(FMI3_OVERRIDE_FUNCTION_PREFIX) || \
    FMI_VERSION == 2 && !defined(FMI2_FUNCTION_PREFIX)
#define FMI_NAME(name) name
#if defined(_WIN32)
#define FMI_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI_EXPORT __attribute__((visibility("default")))
#else
#define FMI_EXPORT
#endif
#else
#define FMI_EXPORT
#define FMI_JOIN(a, b) a##_##b
#define FMI_JOIN_VALUES(a, b) FMI_JOIN(a, b)
#define FMI_NAME(name) FMI_JOIN_VALUES(MODEL_IDENTIFIER, name)
#endif

#endif
