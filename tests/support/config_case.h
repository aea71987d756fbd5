/* config_case.h - texts of cast.yaml, for tests of how castrun reads and resolves them. */
#ifndef TESTS_SUPPORT_CONFIG_CASE_H
#define TESTS_SUPPORT_CONFIG_CASE_H

#include "cast/config/config.h"

extern const char CONFIG_LEAST[]; // the keys that must be there

/* Of `text`, as if it were the file `path`. What is returned here is the caller's; what fails, fails the test. */
CastConfig *config_case_read(const char *text, const char *path);
/* Of CONFIG_LEAST with the piece `old` replaced. */
CastConfig *config_case_with(const char *old, const char *piece);
/* Resolved, and that text read as a file of another folder. */
CastConfig *config_case_again(const CastConfig *config);

void config_case_same_table(const Table *a, const Table *b); // bits
void config_case_same_drive(const Drive *a, const Drive *b); // but for a last bit of directions

#endif
