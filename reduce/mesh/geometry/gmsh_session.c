#include "reduce/mesh/geometry/gmsh_session.h"

#include <gmshc.h>
#include <stdio.h>
#include <string.h>

CastStatus gmsh_session_open(CastError *err)
{
  int ierr;
  gmshInitialize(0, NULL, 0, &ierr);
  CAST_CHECK(ierr == 0, err, CAST_ERR_LIBRARY, "gmsh cannot be started");
  gmshOptionSetNumber("General.Terminal", 0, &ierr);
  gmshOptionSetNumber("General.NumThreads", 1, &ierr); // the same mesh on every machine
  // gmsh throws at an error by default, from within parallel regions too, which ends the process
  gmshOptionSetNumber("General.AbortOnError", 0, &ierr);
  gmshLoggerStart(&ierr);
  return CAST_OK;
}

void gmsh_session_close(void)
{
  int ierr;
  gmshFinalize(&ierr);
}

/* The errors of gmsh's log since the last time, joined by "; ". */
static void take_errors(char *text, size_t size)
{
  char **lines = NULL;
  size_t n = 0;
  int ierr;
  gmshLoggerGet(&lines, &n, &ierr);
  for (size_t i = 0; i < n; i++) {
    const size_t used = strlen(text);
    if (strncmp(lines[i], "Error", 5) == 0 && !strstr(text, lines[i]))
      snprintf(text + used, size - used, "%s%s", used ? "; " : "", lines[i]);
    gmshFree(lines[i]);
  }
  gmshFree(lines);
  gmshLoggerStop(&ierr);
  gmshLoggerStart(&ierr);
}

CastStatus gmsh_session_check(int ierr, const char *doing, CastError *err)
{
  char text[2048] = "";
  take_errors(text, sizeof text);
  CAST_CHECK(ierr == 0 && text[0] == '\0', err, CAST_ERR_INPUT, "%s: gmsh says: %s", doing,
             text[0] ? text : "(it fails without a reason)");
  return CAST_OK;
}

void gmsh_session_forget(void)
{
  char text[64] = "";
  take_errors(text, sizeof text);
}
