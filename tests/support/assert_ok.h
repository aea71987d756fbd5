/* assert_ok.h - what must succeed; says why it did not. */
#ifndef TESTS_SUPPORT_ASSERT_OK_H
#define TESTS_SUPPORT_ASSERT_OK_H

#include "common/error.h"

static inline void ok(CastStatus status, const CastError *err)
{
  if (status != CAST_OK) fail_msg("%s", err->message);
}

#endif
