/* config_matrices.c - a mould that another program has assembled: E, K (or A), B, C as files. */
#include "reduce/config/config_private.h"

#include <stdlib.h>
#include <string.h>
#include "common/hash.h"

/* One file: its path, and its digest appended to `digests`. */
static CastStatus read_file(YamlNode node, const ReduceConfig *config, char **path, char *digests, CastError *err)
{
  const char *file = yaml_string(node, NULL);
  if (!file) return CAST_OK;
  *path = yaml_path_beside(config->input_path, file);
  CAST_CHECK(*path, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  CastError fault;
  char digest[65];
  if (hash_file(*path, digest, &fault) != CAST_OK)
    yaml_problem(node, "%s", fault.message);
  else
    strcat(digests, digest);
  return CAST_OK;
}

static CastStatus read_files(YamlNode node, const ReduceConfig *config, MatricesConfig *read, char *digests,
                             CastError *err)
{
  const YamlNode K = yaml_get(node, "K"), A = yaml_get(node, "A");
  if (yaml_is_map(node) && yaml_exists(K) == yaml_exists(A))
    yaml_problem(node, "either K, as in E dT/dt = -K T + B q, or A = -K is expected");
  read->K_is_A = yaml_exists(A);
  CAST_CALL(read_file(yaml_require(node, "E"), config, &read->E, digests, err));
  CAST_CALL(read_file(read->K_is_A ? A : K, config, &read->K, digests, err));
  CAST_CALL(read_file(yaml_require(node, "B"), config, &read->B, digests, err));
  return read_file(yaml_get(node, "C"), config, &read->C, digests, err);
}

CastStatus config_read_matrices(YamlNode root, ReduceConfig *config, CastError *err)
{
  static const char *const inputs[] = {"watts", "flux", NULL};
  static const char *const others[] = {"geometry", "regions", "boundaries", "cavity", "mesh"};
  const YamlNode node = yaml_get(root, "matrices");
  for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
    const YamlNode other = yaml_get(root, others[i]);
    if (yaml_exists(other))
      yaml_problem(other, "the model comes from matrices, which know no geometry: leave this out");
  }
  char digests[4 * 64 + 1] = "";
  config->matrices = calloc(1, sizeof *config->matrices);
  CAST_CHECK(config->matrices, err, CAST_ERR_MEMORY, CONFIG_NO_MEMORY);
  config->matrices->flux = yaml_choice(yaml_get(node, "inputs"), inputs, 0) == 1;
  CAST_CALL(read_files(node, config, config->matrices, digests, err));
  hash_bytes(digests, strlen(digests), config->geometry_sha256);
  return CAST_OK;
}

void config_matrices_destroy(MatricesConfig **matrices)
{
  if (!*matrices) return;
  free((*matrices)->E);
  free((*matrices)->K);
  free((*matrices)->B);
  free((*matrices)->C);
  free(*matrices);
  *matrices = NULL;
}
