#include "devices/capture/profile_blob.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace seamwright {
namespace {

static_assert(std::endian::native == std::endian::little, "blobs are written as they lie in memory");

constexpr std::array<char, 4> kMagic{'S', 'W', 'P', 'B'};
constexpr std::uint16_t kVersion = 1;
constexpr std::uint16_t kProfileRecords = 1, kCaptureRecords = 2, kFrameRecords = 3;
constexpr std::size_t kHeaderBytes = 16;
constexpr std::uint32_t kMaxLines = 65536;
constexpr std::uint8_t kMaxPerLine = 64;
constexpr std::uint8_t kHasIntensity = 1, kHasSegment = 2, kSameX = 4;
constexpr std::size_t kMaxImageSide = 65536;

class Writer {
  public:
    explicit Writer(std::vector<std::byte>& out) : out_(out) {}
    template <class T>
    void value(T v) {
        raw(&v, sizeof v);
    }
    template <class T>
    void values(const std::vector<T>& v) {
        raw(v.data(), v.size() * sizeof(T));
    }
    void text(const std::string& s) {
        value(static_cast<std::uint16_t>(s.size()));
        raw(s.data(), s.size());
    }
    void raw(const void* data, std::size_t bytes) {
        const auto* p = static_cast<const std::byte*>(data);
        out_.insert(out_.end(), p, p + bytes);
    }

  private:
    std::vector<std::byte>& out_;
};

class Reader {
  public:
    explicit Reader(std::span<const std::byte> in) : in_(in) {}
    bool ok() const { return ok_; }
    std::size_t left() const { return in_.size(); }
    template <class T>
    T value() {
        T v{};
        take(&v, sizeof v);
        return v;
    }
    template <class T>
    void values(std::vector<T>& v, std::size_t n) {
        if (!ok_ || n > in_.size() / sizeof(T)) {
            ok_ = false;
            return;
        }
        v.resize(n);
        take(v.data(), n * sizeof(T));
    }
    std::string text() {
        const auto n = value<std::uint16_t>();
        if (!ok_ || n > in_.size()) {
            ok_ = false;
            return {};
        }
        std::string s(n, '\0');
        take(s.data(), n);
        return s;
    }
    void fail() { ok_ = false; }

  private:
    void take(void* out, std::size_t bytes) {
        if (!ok_ || bytes > in_.size()) {
            ok_ = false;
            return;
        }
        if (bytes) std::memcpy(out, in_.data(), bytes);
        in_ = in_.subspan(bytes);
    }
    std::span<const std::byte> in_;
    bool ok_ = true;
};

bool whole(const Profile& p) {
    const std::size_t n = p.x_mm.size();
    return n <= 0xffffffffu && p.z_mm.size() == n && (p.intensity.empty() || p.intensity.size() == n) &&
           (p.segment.empty() || p.segment.size() == n);
}

bool whole(const ProfileCandidates& k) {
    if (k.lines < 0 || k.lines > static_cast<int>(kMaxLines) || k.per_line < 1 || k.per_line > kMaxPerLine)
        return false;
    const std::size_t n = static_cast<std::size_t>(k.lines) * static_cast<std::size_t>(k.per_line);
    if (k.count.size() < static_cast<std::size_t>(k.lines) || k.x_mm.size() < n || k.z_mm.size() < n ||
        k.intensity.size() < n)
        return false;
    return std::all_of(k.count.begin(), k.count.begin() + k.lines,
                       [&](int count) { return count <= k.per_line; });
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return !a.empty() && a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// `last_x_mm`: x of the profile before, where a repeated one may be left out.
void write_profile(Writer& w, const Profile& p, std::vector<double>* last_x_mm = nullptr) {
    const std::size_t n = p.x_mm.size();
    const bool intensity = n && p.intensity.size() == n, segment = n && p.segment.size() == n;
    const bool same = last_x_mm && same_bits(p.x_mm, *last_x_mm);
    w.value(static_cast<std::uint32_t>(n));
    w.value(static_cast<std::uint8_t>((intensity ? kHasIntensity : 0) | (segment ? kHasSegment : 0) |
                                      (same ? kSameX : 0)));
    if (!same) w.values(p.x_mm);
    w.values(p.z_mm);
    if (intensity) w.values(p.intensity);
    if (segment) w.values(p.segment);
    if (last_x_mm && !same) *last_x_mm = p.x_mm;
}

void read_profile(Reader& r, Profile& p, std::vector<double>* last_x_mm = nullptr) {
    const auto n = r.value<std::uint32_t>();
    const auto columns = r.value<std::uint8_t>();
    if (columns & ~(kHasIntensity | kHasSegment | (last_x_mm ? kSameX : 0))) r.fail();
    if (columns & kSameX) {
        if (!last_x_mm || last_x_mm->size() != n) r.fail();
        if (!r.ok()) return;
        r.values(p.z_mm, n);
        if (r.ok()) p.x_mm = *last_x_mm;
    } else {
        r.values(p.x_mm, n);
        r.values(p.z_mm, n);
        if (last_x_mm && r.ok()) *last_x_mm = p.x_mm;
    }
    if (columns & kHasIntensity) r.values(p.intensity, n);
    if (columns & kHasSegment) r.values(p.segment, n);
}

void write_head(Writer& w, const std::string& spot_id, const std::string& sensor_id, FrameStatus status,
                std::uint64_t sequence, std::int64_t device_time_ns, std::int64_t host_time_ns,
                const std::optional<Pose>& base_from_flange) {
    w.text(spot_id);
    w.text(sensor_id);
    w.value(static_cast<std::uint8_t>(status));
    w.value(sequence);
    w.value(device_time_ns);
    w.value(host_time_ns);
    w.value(static_cast<std::uint8_t>(base_from_flange ? 1 : 0));
    if (base_from_flange)
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) w.value(base_from_flange->matrix()(row, column));
}

void write_candidates(Writer& w, const ProfileCandidates& k) {
    w.value(static_cast<std::uint32_t>(k.lines));
    w.value(static_cast<std::uint8_t>(k.per_line));
    for (int line = 0; line < k.lines; ++line) {
        const std::uint8_t count = k.count[static_cast<std::size_t>(line)];
        w.value(count);
        for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(k.index(line, i));
            w.value(k.x_mm[at]);
            w.value(k.z_mm[at]);
            w.value(k.intensity[at]);
        }
    }
}

void write_capture(Writer& w, const Capture& c) {
    write_head(w, c.spot_id, c.sensor_id, c.status, c.sequence, c.device_time_ns, c.host_time_ns,
               c.base_from_flange);
    write_profile(w, c.profile);
    write_candidates(w, c.candidates);
}

void read_capture(Reader& r, Capture& c, std::vector<double>* last_x_mm = nullptr) {
    c.spot_id = r.text();
    c.sensor_id = r.text();
    const auto status = r.value<std::uint8_t>();
    if (status > static_cast<std::uint8_t>(FrameStatus::late)) r.fail();
    c.status = static_cast<FrameStatus>(r.ok() ? status : 0);
    c.sequence = r.value<std::uint64_t>();
    c.device_time_ns = r.value<std::int64_t>();
    c.host_time_ns = r.value<std::int64_t>();
    const auto posed = r.value<std::uint8_t>();
    if (posed > 1) r.fail();
    if (posed == 1) {
        Pose pose = Pose::Identity();
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) pose.matrix()(row, column) = r.value<double>();
        c.base_from_flange = pose;
    }
    read_profile(r, c.profile, last_x_mm);
    ProfileCandidates& k = c.candidates;
    const auto lines = r.value<std::uint32_t>();
    const auto per_line = r.value<std::uint8_t>();
    // Each line takes a byte at least; the other limits keep a forged header from asking for gigabytes.
    if (lines > r.left() || lines > kMaxLines || per_line > kMaxPerLine || (lines && !per_line)) r.fail();
    if (!r.ok() || !lines) return;
    k.lines = static_cast<int>(lines);
    k.per_line = per_line;
    const std::size_t n = static_cast<std::size_t>(lines) * per_line;
    k.count.assign(lines, 0);
    k.x_mm.assign(n, 0.0);
    k.z_mm.assign(n, 0.0);
    k.intensity.assign(n, 0.0f);
    for (int line = 0; line < k.lines && r.ok(); ++line) {
        const auto count = r.value<std::uint8_t>();
        if (count > per_line) r.fail();
        if (!r.ok()) return;
        k.count[static_cast<std::size_t>(line)] = count;
        for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(k.index(line, i));
            k.x_mm[at] = r.value<double>();
            k.z_mm[at] = r.value<double>();
            k.intensity[at] = r.value<float>();
        }
    }
}

bool known_depth(int depth) {
    return depth == 8 || depth == 10 || depth == 12 || depth == 16;
}

void read_image(Reader& r, Capture& c) {
    const auto present = r.value<std::uint8_t>();
    if (present > 1) r.fail();
    if (!r.ok() || !present) return;
    StoredImage image;
    const auto width = r.value<std::uint32_t>(), height = r.value<std::uint32_t>();
    const auto depth = r.value<std::uint8_t>();
    if (width > kMaxImageSide || height > kMaxImageSide || !known_depth(depth)) r.fail();
    if (!r.ok()) return;
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    image.bit_depth = depth;
    r.values(image.pixels, std::size_t{width} * height * (depth > 8 ? 2 : 1));
    if (r.ok()) c.image = std::move(image);
}

void open_blob(std::vector<std::byte>& out, std::uint16_t kind) {
    Writer w(out);
    w.raw(kMagic.data(), kMagic.size());
    w.value(kVersion);
    w.value(kind);
    w.value(std::uint32_t{0});
    w.value(std::uint32_t{0});
}

std::uint32_t checksum(std::span<const std::byte> payload) {
    return static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(payload.data()), payload.size()));
}

void close_blob(std::vector<std::byte>& blob, std::uint32_t records) {
    const std::uint32_t crc = checksum(std::span<const std::byte>(blob).subspan(kHeaderBytes));
    std::memcpy(blob.data() + 8, &records, 4);
    std::memcpy(blob.data() + 12, &crc, 4);
}

// The payload and the number of records.
Expected<std::pair<std::span<const std::byte>, std::uint32_t>> checked(std::span<const std::byte> blob,
                                                                       std::uint16_t kind,
                                                                       const std::string& where) {
    Reader r(blob);
    std::array<char, 4> magic{};
    for (char& c : magic) c = r.value<char>();
    const auto version = r.value<std::uint16_t>();
    const auto found = r.value<std::uint16_t>();
    const auto records = r.value<std::uint32_t>();
    const auto crc = r.value<std::uint32_t>();
    if (!r.ok() || magic != kMagic) return file_error("this is no block of profiles", where);
    if (version > kVersion)
        return file_error(Text("the block of profiles has version {}, known is {}", version, kVersion), where,
                          "open it with a newer Seamwright");
    if (version != kVersion || found != kind) return file_error("this is another kind of block", where);
    const auto payload = blob.subspan(kHeaderBytes);
    if (checksum(payload) != crc)
        return file_error("the checksum of the profiles is wrong: the file is damaged", where);
    return std::pair{payload, records};
}

}  // namespace

Expected<std::vector<std::byte>> pack_profile(const Profile& profile) {
    if (!whole(profile)) return input_error("the columns of the profile differ in length");
    std::vector<std::byte> blob;
    open_blob(blob, kProfileRecords);
    Writer w(blob);
    write_profile(w, profile);
    close_blob(blob, 1);
    return blob;
}

Expected<Profile> unpack_profile(std::span<const std::byte> blob, const std::string& where) {
    SEAM_TRY(auto payload, checked(blob, kProfileRecords, where));
    Reader r(payload.first);
    Profile profile;
    read_profile(r, profile);
    if (!r.ok() || r.left() || payload.second != 1) return file_error("the profile is not whole", where);
    return profile;
}

Expected<std::vector<CaptureBlob>> pack_captures(std::span<const Capture> captures,
                                                 std::size_t target_bytes) {
    std::vector<CaptureBlob> blobs;
    for (const Capture& capture : captures) {
        if (!whole(capture.profile) || !whole(capture.candidates) || capture.spot_id.size() > 0xffff ||
            capture.sensor_id.size() > 0xffff)
            return input_error(
                "the capture does not fit the file's format (columns of different length, or too long)",
                Text("capture of spot {}", capture.spot_id.substr(0, 40)));
        if (blobs.empty() || blobs.back().bytes.size() >= target_bytes) {
            if (!blobs.empty())
                close_blob(blobs.back().bytes, static_cast<std::uint32_t>(blobs.back().captures));
            blobs.emplace_back();
            open_blob(blobs.back().bytes, kCaptureRecords);
            blobs.back().bytes.reserve(target_bytes + target_bytes / 8);
        }
        Writer w(blobs.back().bytes);
        write_capture(w, capture);
        ++blobs.back().captures;
    }
    if (!blobs.empty()) close_blob(blobs.back().bytes, static_cast<std::uint32_t>(blobs.back().captures));
    return blobs;
}

Expected<void> unpack_captures(std::span<const std::byte> blob, const std::string& where,
                               std::vector<Capture>& captures) {
    SEAM_TRY(auto payload, checked(blob, kCaptureRecords, where));
    Reader r(payload.first);
    for (std::uint32_t i = 0; i < payload.second && r.ok(); ++i) {
        captures.emplace_back();
        read_capture(r, captures.back());
        if (!r.ok()) captures.pop_back();
    }
    if (!r.ok() || r.left()) return file_error("the block of profiles is not whole", where);
    return {};
}

void FrameBlock::clear() {
    blob_.clear();
    frames_ = 0;
    last_x_mm_.clear();
    open_blob(blob_, kFrameRecords);
}

Expected<void> FrameBlock::append(const Frame& frame, const ProfileCandidates* candidates, bool with_image) {
    const StripeImage& image = frame.image;
    const std::size_t row_bytes = static_cast<std::size_t>(std::max(image.width, 0)) *
                                  static_cast<std::size_t>(image.bytes_per_pixel());
    const bool keep = with_image && !image.empty();
    if (!whole(frame.profile) || (candidates && !whole(*candidates)) || frame.spot_id.size() > 0xffff ||
        (keep && (image.row_bytes < row_bytes || !known_depth(image.bit_depth) ||
                  static_cast<std::size_t>(image.width) > kMaxImageSide ||
                  static_cast<std::size_t>(image.height) > kMaxImageSide)))
        return input_error(
            "the frame does not fit the file's format (columns of different length, or too long)",
            Text("frame {}", frame.sequence));
    Writer w(blob_);
    write_head(w, frame.spot_id, {}, frame.status, frame.sequence, frame.device_time_ns, frame.host_time_ns,
               frame.base_from_flange);
    write_profile(w, frame.profile, &last_x_mm_);
    static const ProfileCandidates kNone;
    write_candidates(w, candidates ? *candidates : kNone);
    w.value(static_cast<std::uint8_t>(keep ? 1 : 0));
    if (keep) {
        w.value(static_cast<std::uint32_t>(image.width));
        w.value(static_cast<std::uint32_t>(image.height));
        w.value(static_cast<std::uint8_t>(image.bit_depth));
        if (image.row_bytes == row_bytes) {
            w.raw(image.pixels, row_bytes * static_cast<std::size_t>(image.height));
        } else {
            for (int y = 0; y < image.height; ++y)
                w.raw(image.pixels + static_cast<std::size_t>(y) * image.row_bytes, row_bytes);
        }
    }
    ++frames_;
    return {};
}

std::span<const std::byte> FrameBlock::finish() {
    close_blob(blob_, static_cast<std::uint32_t>(frames_));
    return blob_;
}

std::size_t frame_record_bytes(const Frame& frame, const ProfileCandidates* candidates, bool with_image) {
    const Profile& p = frame.profile;
    std::size_t bytes = 256 + frame.spot_id.size() + 8 * (p.x_mm.size() + p.z_mm.size()) +
                        4 * (p.intensity.size() + p.segment.size());
    if (candidates) bytes += candidates->count.size() + 20 * candidates->x_mm.size();
    if (with_image && !frame.image.empty())
        bytes += static_cast<std::size_t>(frame.image.width) * static_cast<std::size_t>(frame.image.height) *
                 static_cast<std::size_t>(frame.image.bytes_per_pixel());
    return bytes;
}

Expected<void> unpack_frames(std::span<const std::byte> blob, const std::string& where,
                             std::vector<Capture>& captures) {
    SEAM_TRY(auto payload, checked(blob, kFrameRecords, where));
    Reader r(payload.first);
    std::vector<double> last_x_mm;
    for (std::uint32_t i = 0; i < payload.second && r.ok(); ++i) {
        Capture& c = captures.emplace_back();
        read_capture(r, c, &last_x_mm);
        if (r.ok()) read_image(r, c);
        if (!r.ok()) captures.pop_back();
    }
    if (!r.ok() || r.left()) return file_error("the block of frames is not whole", where);
    return {};
}

}  // namespace seamwright
