/* error.h - how PETSc-free code reports that something went wrong.
 * A function that can fail returns a CastStatus and takes a CastError as its last argument; the message names the
 * thing, what was found, what was expected and the unit, and for input the file and line. Library code never prints
 * and never exits. */
#ifndef COMMON_ERROR_H
#define COMMON_ERROR_H

typedef enum CastStatus {
  CAST_OK = 0,
  CAST_ERR_ARGUMENT, // a caller broke a function's contract
  CAST_ERR_INPUT,    // what the user wrote cannot be used
  CAST_ERR_FORMAT,   // a file is damaged, foreign, newer or inconsistent
  CAST_ERR_IO,       // the system refused to read or write
  CAST_ERR_MEMORY,   // an allocation failed
  CAST_ERR_NUMERIC,  // NaN, a collapse of the time step, a solver that does not converge
  CAST_ERR_LIBRARY   // a library we call failed
} CastStatus;

typedef struct CastError {
  CastStatus code;
  char message[8192];
} CastError;

/* Record `code` and the formatted message in err (may be NULL) and return `code`. */
CastStatus cast_error_set(CastError *err, CastStatus code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Put "text: " in front of the message that err holds; returns err->code. */
CastStatus cast_error_prefix(CastError *err, const char *text);

#define CAST_CALL(call)                                                                                                \
  do {                                                                                                                 \
    const CastStatus cast_status_ = (call);                                                                            \
    if (cast_status_ != CAST_OK) return cast_status_;                                                                  \
  } while (0)

/* CAST_CHECK(condition, err, code, format, ...): return with an error unless the condition holds. */
#define CAST_CHECK(condition, err, code, ...)                                                                          \
  do {                                                                                                                 \
    if (!(condition)) return cast_error_set((err), (code), __VA_ARGS__);                                               \
  } while (0)

#endif
