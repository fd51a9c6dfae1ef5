// seamwright extract: stripe peaks of a camera image.

#include <fmt/format.h>

#include <cmath>

#include "app/cli/command.h"
#include "core/profile/stripe/peaks.h"
#include "devices/exchange/files.h"
#include "devices/exchange/image_file.h"

namespace seamwright::cli {
namespace {

constexpr float kStep_px = 3;  // of a stripe from one line to the next

struct ExtractArguments {
    std::string image, off, out, method = "centre-of-gravity", channel = "automatic";
    bool rows = false, columns = false;
    PeakOptions options;
};

Expected<Answer> extract(ExtractArguments a) {
    if (a.method == "centre-of-gravity")
        a.options.method = PeakMethod::centre_of_gravity;
    else if (a.method == "gaussian")
        a.options.method = PeakMethod::gaussian;
    else
        a.options.method = PeakMethod::steger;
    SEAM_TRY(auto choice, choose_channel(a.image));
    const ImageChannel channel = a.channel == "automatic" ? choice.channel : *image_channel(a.channel);
    Frame frame;
    SEAM_OK(read_image_file(a.image, frame, 0, channel));
    if (!a.off.empty()) {
        Frame off;
        SEAM_OK(read_image_file(a.off, off, 0, channel));
        if (auto taken = subtract_image(frame, off); !taken) {
            taken.error().where = a.off;
            return tl::unexpected(taken.error());
        }
    }
    if (a.rows) {
        a.options.scan = ScanLines::rows;
    } else if (!a.columns) {
        SEAM_TRY(auto guess, guess_scan_lines(frame.image));
        a.options.scan = guess;
    }
    StripePeaks peaks;
    SEAM_OK(find_peaks(frame.image, a.options, peaks));
    std::string csv = "index,position_px,intensity,width_px,peak\n";
    int lines_with_stripe = 0, lines_going_on = 0;
    for (int line = 0; line < peaks.lines; ++line) {
        if (peaks.count[line]) ++lines_with_stripe;
        if (line > 0 && peaks.count[line] && peaks.count[line - 1] &&
            std::abs(peaks.position_px[peaks.index(line, 0)] - peaks.position_px[peaks.index(line - 1, 0)]) <=
                kStep_px)
            ++lines_going_on;
        for (int k = 0; k < peaks.count[line]; ++k) {
            const int i = peaks.index(line, k);
            fmt::format_to(std::back_inserter(csv), "{},{:.4f},{:.1f},{:.3f},{}\n", line,
                           peaks.position_px[i], peaks.intensity[i], peaks.width_px[i], k);
        }
    }
    SEAM_OK(write_text_file(a.out, csv));
    const char* scan = peaks.scan == ScanLines::rows ? "rows" : "columns";
    Answer answer;
    answer.json = {{"status", lines_with_stripe ? "ok" : "no_stripe"},
                   {"scan", scan},
                   {"lines", peaks.lines},
                   {"lines_with_stripe", lines_with_stripe},
                   {"lines_going_on", lines_going_on},
                   {"colour", choice.colour},
                   {"channel", to_string(channel)},
                   {"width", frame.image.width},
                   {"height", frame.image.height},
                   {"bit_depth", frame.image.bit_depth}};
    answer.text =
        fmt::format("{} of {} {} have a peak, {} of them beside that of the {} before\n", lines_with_stripe,
                    peaks.lines, scan, lines_going_on, peaks.scan == ScanLines::rows ? "row" : "column");
    if (choice.colour) answer.text += fmt::format("colour: read in {}\n", to_string(channel));
    std::vector<std::string> warnings;
    if (choice.colour && channel == ImageChannel::grey && choice.channel != ImageChannel::grey)
        warnings.push_back(
            fmt::format("colour is folded to grey; in {} a line goes on over {:.0f} % of the lines, in "
                        "grey over {:.0f} %",
                        to_string(choice.channel), 100 * choice.share, 100 * choice.share_grey));
    if (choice.mosaic) warnings.push_back(mosaic_warning().english());
    if (lines_with_stripe > 0 && 2 * lines_going_on < lines_with_stripe)
        warnings.push_back(
            "the strongest peaks jump from line to line: they may be no laser stripe (--channel, "
            "--laser-off, "
            "--threshold)");
    for (const std::string& w : warnings) answer.text += "warning: " + w + "\n";
    answer.json["warnings"] = warnings;
    answer.exit_code = lines_with_stripe ? kExitOk : kExitVerdict;
    return answer;
}

}  // namespace

void add_extract(CommandLine& line) {
    auto a = std::make_shared<ExtractArguments>();
    CLI::App* command =
        line.add("extract", "Where the laser stripe crosses each row or column of a camera image.",
                 "seamwright extract frame.png --rows --peaks 3 --out peaks.csv\n"
                 "  columns: index,position_px,intensity,width_px,peak (0 = strongest)");
    command->add_option("image", a->image, "PNG, BMP, TIFF or PGM, 8 or 16 bit")
        ->required()
        ->type_name("IMAGE");
    command->add_option("--out", a->out, "Where the peaks go")->required()->type_name("OUT.csv");
    auto* rows = command->add_flag("--rows", a->rows, "One cut per image row (stripe runs top to bottom)");
    command
        ->add_flag("--columns", a->columns,
                   "One cut per image column (stripe runs left to right); default: seen from the image")
        ->excludes(rows);
    command->add_option("--peaks", a->options.per_line, "Candidates per line, strongest first")
        ->capture_default_str()
        ->check(CLI::Range(1, 16));
    command->add_option("--method", a->method, "How the sub-pixel position is found")
        ->check(CLI::IsMember({"centre-of-gravity", "gaussian", "steger"}))
        ->capture_default_str();
    command->add_option("--threshold", a->options.threshold, "Grey value above background; 0 = automatic")
        ->capture_default_str();
    command
        ->add_option(
            "--channel", a->channel,
            "Colour images: grey, red, green, blue, red-difference (R - (G+B)/2), or automatic: in which a "
            "thin bright line stands out best")
        ->check(CLI::IsMember({"automatic", "grey", "red", "green", "blue", "red-difference"}))
        ->capture_default_str();
    command->add_option("--laser-off", a->off, "The same place with the laser off: taken away from IMAGE")
        ->type_name("IMAGE");
    line.on(command, [a] { return extract(*a); });
}

}  // namespace seamwright::cli
