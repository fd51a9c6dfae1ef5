#include <fmt/format.h>

#include "devices/line/mqtt.h"
#include "devices/line/register_map.h"

namespace seamwright {
namespace {

constexpr const char* kHandshake = R"(## Start, busy, done

Setting "start": "line". The line starts the parts.

1. The line writes part_type, paint, part_number and part_name, then start 1. With one write of all of them, or start last.
2. The station answers busy 1.
3. The station answers busy 0 and done 1: result, alarm, run and regions are of this part.
4. The line writes start 0. The station answers done 0, and ready 1 where the next part may come.

A start that is 1 when the station begins, when the connection comes back or after an alarm 34 starts nothing: the line writes
0 first. Start 0 before busy withdraws the call. Start 0 while busy gives the part up: what is measured is measured to its
end, but no robot is waited for any longer; done stays until the next start, and ready 1 beside it says that this may come.
A part that ends while the connection is away is answered when it is back: by step 4 where start is still 1, else as one
that was given up. Where start is 1 for another part than the one that was called, that one is given up, and the call for
the other ends as one that the station cannot follow: with done 1, result 8 and alarm 30, as after call_timeout_ms.

Setting "start": "robot" (where nothing is set). The robot's call starts the part; what stands in part_type, paint,
part_number and part_name at that instant goes with it. start is not looked at; busy and done follow the station.

Nothing that a line writes reaches a robot. It names a part and calls for it; the safety gate judges as ever.
)";

constexpr const char* kModbus = R"(## Modbus TCP

modbus-server: the PLC connects. Functions 3 and 4 read every register, 6 and 16 write those of the line; any other function
gets exception 1, any other address 2, counts and lengths that are none 3, another unit 11. A connection that is silent for
idle_ms, in the middle of a frame for 1 s, or sends what is no frame is closed. One answer is of one instant.

modbus-client: the PLC is the server and holds the same registers, the line's at read_address, the station's at write_address.
They are read and written every poll_ms, regions before the rest; the status of regions that there are not becomes 0 with the
connection, where the PLC has these words.

Addresses count from 0. Two words: the high word first (big endian). Texts: two signs a word, the first in the high byte, ended
by 0. Lengths are counted in 0.001 mm and angles in 0.001 degree, standard deviations are rounded up; -2147483648 is no value.
)";

constexpr const char* kMqtt = R"(## MQTT

QoS 1, JSON, topics after Sparkplug's pattern. GROUP and NODE are settings; '/', '+', '#' and '$' in them become '_'.

| topic | kept by the broker | |
|---|---|---|
| `seamwright/GROUP/STATE/NODE` | yes | `{"version":1,"online":true,"utc","state":"ready"\|"busy"\|"not_ready","part","parts","alarm","text"}`; the last will is `{"version":1,"online":false}` |
| `seamwright/GROUP/NDATA/NODE` | yes | `{"version":1,"utc","part","part_type","paint","part_number","part_name","run","result","alarm","seconds","text","regions":[{"id","passed","refusal","shift_mm":[x,y,z],"shift_abc_deg":[a,b,c],"sigma_mm":[x,y,z],"sigma_abc_deg":[a,b,c]}]}`; shifts are null where nothing was solved |
| `seamwright/GROUP/NCMD/NODE` | no | to the station: `{"id":"7","start":true,"part_type":1,"paint":3,"part_number":815,"part_name":"CAR-0815"}` |

A command's "id" is another one each time: one of the last thousand again is a repetition and does nothing. Kept (retained) commands are not
obeyed. "start": true calls for a part where the setting "start" is "line", false gives it up; without "start" the part is
announced for the robot's next call, and for that one alone. Once the robot has called a part by the name that the line had
announced, another name is another part: what was announced is not taken for it. Results wait while the broker is away, as many as the setting
"queue" says, and one may come twice; "run" tells.
)";

std::string row(std::string_view address, const LineRegister& r) {
    return fmt::format("| {} | {} | {} | {} | {} | {} |\n", address, r.words, to_string(r.type), r.name,
                       r.writable() ? "line" : "station", r.help);
}

std::string codes(const char* title, const std::vector<LineCode>& list) {
    std::string text = fmt::format("\n## {}\n\n| number | name | |\n|---|---|---|\n", title);
    for (const LineCode& code : list)
        text += fmt::format("| {} | {} | {} |\n", code.number, code.name, code.help);
    return text;
}

}  // namespace

std::string line_document() {
    std::string text = fmt::format(
        "# Line control\n\nWritten by `seamwright line registers`. Protocol version {}. The settings of each "
        "protocol: devices/SETTINGS.md.\n\n{}\n{}\n",
        kLineProtocolVersion, kHandshake, kModbus);
    const std::string head = "| address | words | type | name | written by | |\n|---|---|---|---|---|---|\n";
    text += head;
    for (const LineRegister& r : line_registers()) text += row(std::to_string(r.address), r);
    text += fmt::format(
        "\nRegions in the project's order, at most {}: region k (0, 1, ...) begins at {} + {} k.\n\n{}",
        kLineRegions, kRegionWords, kRegionStride, head);
    for (const LineRegister& r : line_region_registers())
        text += row(fmt::format("{} + {} k", kRegionWords + r.address, kRegionStride), r);
    return text + codes("Results", line_results()) + codes("Alarms", line_alarms()) + "\n" + kMqtt;
}

}  // namespace seamwright
