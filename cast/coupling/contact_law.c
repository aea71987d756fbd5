#include "cast/coupling/contact_law.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cast/coupling/cavity_patches.h"

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

/* surface[l]: index into `laws` of patch l, or -1 */
static CastStatus find_surfaces(const ContactLaws *laws, const RomData *rom, int32_t *surface, CastError *err)
{
  for (size_t l = 0; l < rom->m; l++) surface[l] = -1;
  for (size_t k = 0; k < laws->n; k++)
    CAST_CALL(cavity_patches_set(rom, "contact.surfaces", laws->surface[k].surface, (int32_t)k, surface, err));
  return CAST_OK;
}

CastStatus contact_laws_by_patch(const ContactLaws *laws, const RomData *rom, const Material *melt,
                                 const ContactLaw **law, CastError *err)
{
  CAST_CALL(check_law(&laws->elsewhere, melt, "", err));
  for (size_t k = 0; k < laws->n; k++) {
    char where[ROM_NAME_LENGTH + 8];
    snprintf(where, sizeof where, " of '%s'", laws->surface[k].surface);
    CAST_CALL(check_law(&laws->surface[k].law, melt, where, err));
  }
  int32_t *surface = malloc((rom->m ? rom->m : 1) * sizeof *surface);
  CAST_CHECK(surface, err, CAST_ERR_MEMORY, "no memory for the contacts of %zu patches", rom->m);
  const CastStatus status = find_surfaces(laws, rom, surface, err);
  for (size_t l = 0; l < rom->m && status == CAST_OK; l++)
    law[l] = surface[l] < 0 ? &laws->elsewhere : &laws->surface[surface[l]].law;
  free(surface);
  return status;
}

void contact_laws_destroy(ContactLaws *laws)
{
  table_destroy(&laws->elsewhere.table);
  for (size_t k = 0; k < laws->n; k++) table_destroy(&laws->surface[k].law.table);
  free(laws->surface);
  *laws = (ContactLaws){0};
}
