#pragma once

#include "runtime/base/text_writer.h"
#include "runtime/store/diff.h"
#include "runtime/store/record.h"

namespace roomcal::exports {

/// A record for a person: where it comes from, and one line a sensor (position in mm, angles in degrees, sigmas,
/// evidence).
void write_summary(const store::Record& record, TextWriter& out);

/// A diff for a person: one line a sensor, how far it moved in mm and degrees, and whether that is beyond its
/// covariance.
void write_summary(const store::RecordDiff& diff, TextWriter& out);

}  // namespace roomcal::exports
