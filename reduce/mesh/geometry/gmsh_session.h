/* gmsh_session.h - gmsh, silent: what it has to say becomes part of our errors. gmsh keeps one session for a process.
 */
#ifndef REDUCE_MESH_GEOMETRY_GMSH_SESSION_H
#define REDUCE_MESH_GEOMETRY_GMSH_SESSION_H

#include <stddef.h>
#include "common/error.h"

CastStatus gmsh_session_open(CastError *err);
void gmsh_session_close(void);
/* Has gmsh failed since the last call, by its return code or by an error in its log? `doing` begins the message.
 * Errors: CAST_ERR_INPUT with all that gmsh said. */
CastStatus gmsh_session_check(int ierr, const char *doing, CastError *err);
/* Drop what gmsh said since the last check: for calls that may fail. */
void gmsh_session_forget(void);

#endif
