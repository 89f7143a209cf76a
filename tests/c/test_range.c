/* The trained range and the surface, at their borders and beside them. */
#include <math.h>

#include "check.h"
#include "sp_contact.h"
#include "sp_range.h"

static const sp_range_config range = {.min_m = (sp_real)0.25, .max_m = (sp_real)0.75};
enum { OTHER_NOTE = SP_NOTE_RAMPED }; /* said before by another unit: it stays */

TEST(depth_is_clipped_to_the_trained_range)
{
    const struct {
        sp_real in, out;
        int notes;
    } cases[] = {{(sp_real)0.25, (sp_real)0.25, 0},
                 {(sp_real)0.5, (sp_real)0.5, 0},
                 {(sp_real)0.75, (sp_real)0.75, 0},
                 {(sp_real)0.7501, (sp_real)0.75, SP_NOTE_OUTSIDE},
                 {(sp_real)0.2499, (sp_real)0.25, SP_NOTE_OUTSIDE},
                 {(sp_real)INFINITY, (sp_real)0.75, SP_NOTE_OUTSIDE},
                 {(sp_real)-INFINITY, (sp_real)0.25, SP_NOTE_OUTSIDE}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        int notes = OTHER_NOTE;
        CHECK(sp_range_clip(&range, cases[i].in, &notes) == cases[i].out);
        CHECK(notes == (OTHER_NOTE | cases[i].notes));
    }
}

TEST(force_fades_outside_the_trained_range_and_ends)
{
    const sp_real per_fade = (sp_real)4; /* over 0.25 m */
    const struct {
        sp_real x, share;
    } cases[] = {{(sp_real)0.25, (sp_real)1},      {(sp_real)0.5, (sp_real)1},
                 {(sp_real)0.75, (sp_real)1},      {(sp_real)0.8125, (sp_real)0.75},
                 {(sp_real)0.875, (sp_real)0.5},   {(sp_real)1, (sp_real)0},
                 {(sp_real)2, (sp_real)0},         {(sp_real)0.125, (sp_real)0.5},
                 {(sp_real)0.1875, (sp_real)0.75}, {(sp_real)0, (sp_real)0},
                 {(sp_real)-2, (sp_real)0}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const sp_real force_n = sp_range_fade(&range, per_fade, cases[i].x, (sp_real)8);
        CHECK(force_n == (sp_real)8 * cases[i].share);
    }
    CHECK(sp_range_fade(&range, per_fade, (sp_real)1, (sp_real)INFINITY) == (sp_real)0);
}

TEST(onset_ends_at_its_depth_and_is_zero_at_the_surface)
{
    const sp_real per_onset = (sp_real)1000;
    CHECK(sp_contact_onset(per_onset, (sp_real)0.001, (sp_real)3) == (sp_real)3);
    CHECK(sp_contact_onset(per_onset, (sp_real)0.0015, (sp_real)3) == (sp_real)3);
    CHECK(sp_contact_onset(per_onset, (sp_real)0.0005, (sp_real)3) == (sp_real)1.5);
    CHECK(sp_contact_onset(per_onset, (sp_real)-1, (sp_real)3) == (sp_real)0);
    CHECK(sp_contact_onset(per_onset, (sp_real)0, (sp_real)INFINITY) == (sp_real)0);
    CHECK(sp_contact_onset(per_onset, (sp_real)NAN, (sp_real)3) == (sp_real)0);
}
