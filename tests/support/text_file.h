/* text_file.h - a whole file as a text. */
#ifndef TESTS_SUPPORT_TEXT_FILE_H
#define TESTS_SUPPORT_TEXT_FILE_H

/* Fails the test where there is no such file or nothing in it. The caller frees the text. */
char *text_file_read(const char *path);

#endif
