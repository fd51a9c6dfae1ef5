#pragma once
// The tables of a fleet's database, in its schema "seamwright", and how older ones become current ones. A migration is frozen once
// released; what comes later is one more at the end.
//
// One row of `run` a run, by its id for ever once (unique), with its results (a region's displacement, sigma and values; a panel's
// gaps), refusals and unmeasured spots. `setup` holds what of the stations' projects the numbers need: limits, places, names; no
// settings of devices. Tables named hour_ and day_ hold of each station and hour or day (UTC) what the statistics add up
// (projects/fleet/sums.h); they say nothing that the runs do not.

#include "projects/fleet/target.h"

namespace seamwright {

struct FleetInit {
    int before = 0;  // 0: there was no schema
    int version = 0;
};
int fleet_schema_version();  // that this program knows
// Makes the schema or brings it up to date, all or nothing; without effect on a current one. Programs that know another version
// publish nothing from then on. Minutes for a million runs that are there. Error (device): it is newer, no server, no right.
Expected<FleetInit> init_fleet(const FleetTarget& target);

}  // namespace seamwright
