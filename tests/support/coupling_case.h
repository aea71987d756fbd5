/* coupling_case.h - aluminium bronze on phosphate, for tests of the exchange between melt and mould. */
#ifndef TESTS_SUPPORT_COUPLING_CASE_H
#define TESTS_SUPPORT_COUPLING_CASE_H

#include "tests/support/melt_on_mould.h"

#define COUPLING_CASE_SPACING 1e-4 // m

/* A layered block on a mould of one patch. */
MeltCase coupling_case_bronze(CouplingKind kind, double h_contact);
/* A block in the middle of a slab of 4 x 4 patches, 30 spacings wide. */
MeltCase coupling_case_block(CouplingKind kind, int across, int high);

void coupling_case_shake(MeltOnMould *melt, double most); // places, by up to half of `most` spacings, and temperatures
void coupling_case_exchange(MeltOnMould *melt);           // alone: without conduction in the melt
double coupling_case_flow(const MeltOnMould *melt);       // of all patches, W
double coupling_case_wetted(const MeltOnMould *melt);     // of all patches, m2

#endif
