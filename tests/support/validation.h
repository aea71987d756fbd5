/* validation.h - how a test writes its rows of docs/validation.md.
 * A row goes to $VALIDATION_DIR/<id>-<test>.md; tests/run.sh gathers the rows into one table. */
#ifndef TESTS_SUPPORT_VALIDATION_H
#define TESTS_SUPPORT_VALIDATION_H

typedef struct ValidationRow {
  const char *id;         // "H1"
  const char *quantity;   // "centre temperature at Fo = 0.1"
  const char *reference;  // "0.47449 (series)"
  const char *ours;       // "0.4751"
  const char *error;      // "0.13 %"
  const char *target;     // "1 %"
  const char *resolution; // "40 particles across, order 1.9"
  double cpu_seconds;
} ValidationRow;

/* Start the file of case `id` anew (a test calls this once, before its rows). */
void validation_begin(const char *id);
void validation_write(const ValidationRow *row);
double validation_cpu_time(void); // s of processor time used by this process so far
/* printf into one of a few rotating static buffers, for the text fields of a row. */
const char *validation_text(const char *format, ...) __attribute__((format(printf, 1, 2)));
#endif
