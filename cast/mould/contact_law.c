#include "cast/mould/contact_law.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double contact_law_at(const ContactLaw *law, const Material *melt, double T)
{
  if (law->basis == CONTACT_CONSTANT) return law->h;
  const bool fraction = law->basis == CONTACT_OF_SOLID_FRACTION;
  return table_evaluate(&law->table, fraction ? table_evaluate(&melt->solid_fraction, T) : T);
}

double contact_law_most(const ContactLaw *law)
{
  if (law->basis == CONTACT_CONSTANT) return law->h;
  double most = 0.0;
  for (size_t i = 0; i < law->table.n; i++) most = fmax(most, law->table.y[i]);
  return most;
}

double contact_laws_most(const ContactLaws *laws)
{
  double most = contact_law_most(&laws->elsewhere);
  for (size_t k = 0; k < laws->n; k++) most = fmax(most, contact_law_most(&laws->surface[k].law));
  return most;
}

static CastStatus check_law(const ContactLaw *law, const Material *melt, const char *where, CastError *err)
{
  if (law->basis == CONTACT_CONSTANT)
    CAST_CHECK(law->h > 0.0, err, CAST_ERR_INPUT,
               "h_contact%s is %g W/(m2 K), above zero is expected (infinite: perfect contact)", where, law->h);
  else
    CAST_CHECK(law->table.n > 0, err, CAST_ERR_INPUT, "h_contact%s is an empty table", where);
  for (size_t i = 0; i < law->table.n; i++)
    CAST_CHECK(law->table.y[i] > 0.0, err, CAST_ERR_INPUT, "h_contact%s is %g W/(m2 K) at %g, above zero is expected",
               where, law->table.y[i], law->table.x[i]);
  CAST_CHECK(law->basis != CONTACT_OF_SOLID_FRACTION || (melt && melt->solid_fraction.n > 0), err, CAST_ERR_INPUT,
             "h_contact%s depends on the solid fraction, and the melt has none (solidus, liquidus or solid_fraction)",
             where);
  return CAST_OK;
}

static CastStatus no_such_surface(const RomData *rom, const char *name, CastError *err)
{
  char known[512] = "";
  for (size_t l = 0; l < rom->m; l++) {
    const RomPatch *patch = &rom->patch[l];
    if (patch->outer || (l > 0 && strcmp(patch->surface, rom->patch[l - 1].surface) == 0)) continue;
    const size_t used = strlen(known);
    snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", patch->surface);
  }
  return cast_error_set(err, CAST_ERR_INPUT, "contact.surfaces: the mould has no cavity surface '%s', it has: %s", name,
                        known);
}

CastStatus contact_laws_by_patch(const ContactLaws *laws, const RomData *rom, const Material *melt,
                                 const ContactLaw **law, CastError *err)
{
  CAST_CALL(check_law(&laws->elsewhere, melt, "", err));
  for (size_t l = 0; l < rom->m; l++) law[l] = &laws->elsewhere;
  for (size_t k = 0; k < laws->n; k++) {
    const SurfaceContact *contact = &laws->surface[k];
    char where[ROM_NAME_LENGTH + 8];
    snprintf(where, sizeof where, " of '%s'", contact->surface);
    CAST_CALL(check_law(&contact->law, melt, where, err));
    size_t found = 0;
    for (size_t l = 0; l < rom->m; l++) {
      if (rom->patch[l].outer || strcmp(rom->patch[l].surface, contact->surface) != 0) continue;
      law[l] = &contact->law;
      found++;
    }
    if (found == 0) return no_such_surface(rom, contact->surface, err);
  }
  return CAST_OK;
}

void contact_laws_destroy(ContactLaws *laws)
{
  table_destroy(&laws->elsewhere.table);
  for (size_t k = 0; k < laws->n; k++) table_destroy(&laws->surface[k].law.table);
  free(laws->surface);
  *laws = (ContactLaws){0};
}
