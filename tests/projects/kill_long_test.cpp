#include <gtest/gtest.h>

#include "tests/projects/kill_test.h"

namespace seamwright {

TEST(KillLong, TwoHundredKills) {
    kill_while_appending(200, 2, false);
}

TEST(KillLong, TwoHundredKillsWithWriteAheadLog) {
    kill_while_appending(200, 4, true);
}

}  // namespace seamwright
