#include "devices/exchange/cloud/cloud_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <iterator>

#include "devices/exchange/files.h"
#include "devices/exchange/tables/point_table.h"

namespace seamwright {
namespace {

constexpr std::size_t kCloudFileLimit = std::size_t{4} << 30;  // bytes

// The columns that a file of ours or of others' tools may hold for one number.
const std::vector<double>* column(const PointTable& table, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names)
        for (std::size_t c = 0; c < table.names.size(); ++c) {
            std::string low = table.names[c];
            std::transform(low.begin(), low.end(), low.begin(),
                           [](unsigned char s) { return static_cast<char>(std::tolower(s)); });
            if (low == name) return &table.columns[c];
        }
    return nullptr;
}

// What a point has besides its place, in the order of the files' columns.
struct Column {
    std::array<const char*, 3> names;
    int count;
};
std::vector<Column> columns_of(const Cloud& cloud) {
    std::vector<Column> out{{{"x", "y", "z"}, 3}};
    if (cloud.has_normals()) out.push_back({{"nx", "ny", "nz"}, 3});
    if (cloud.has_towards()) out.push_back({{"towards_x", "towards_y", "towards_z"}, 3});
    if (cloud.has_sigma()) out.push_back({{"sigma_mm", "", ""}, 1});
    return out;
}

template <class Put>
void each_number(const Cloud& cloud, std::size_t i, const Put& put) {
    for (int k = 0; k < 3; ++k) put(cloud.points[i][k]);
    if (cloud.has_normals())
        for (int k = 0; k < 3; ++k) put(cloud.normals[i][k]);
    if (cloud.has_towards())
        for (int k = 0; k < 3; ++k) put(cloud.towards[i][k]);
    if (cloud.has_sigma()) put(cloud.sigma_mm[i]);
}

std::string binary(std::string head, const Cloud& cloud) {
    std::size_t numbers = 0;
    for (const Column& c : columns_of(cloud)) numbers += static_cast<std::size_t>(c.count);
    std::size_t at = head.size();
    head.resize(at + cloud.size() * numbers * sizeof(float));
    for (std::size_t i = 0; i < cloud.size(); ++i)
        each_number(cloud, i, [&](auto value) {
            const auto f = static_cast<float>(value);
            std::memcpy(head.data() + at, &f, sizeof f);
            at += sizeof f;
        });
    return head;
}

Expected<void> set_scale(Cloud& cloud, const std::string& unit, const std::string& where) {
    if (!unit.empty() && unit != "mm" && unit != "m")
        return input_error(Text("\"{}\" is no unit of a cloud", unit), where, "give \"mm\" or \"m\"");
    const double longest = cloud.box().sizes().maxCoeff();
    if (unit == "m") {
        for (auto& p : cloud.points) p *= 1000;
    } else if (unit.empty() && longest < 10) {
        return input_error(Text("the cloud is only {:.4g} long: metres suspected", longest), where,
                           "say the unit: \"mm\" or \"m\"");
    }
    return {};
}

}  // namespace

Expected<Cloud> parse_cloud(std::string_view bytes, const std::string& where, const std::string& unit) {
    SEAM_TRY(auto table, parse_points(bytes, where, kMostCloudPoints));
    const std::vector<double>*x = column(table, {"x", "x_mm"}), *y = column(table, {"y", "y_mm"}),
          *z = column(table, {"z", "z_mm"});
    if (table.names.empty() && table.columns.size() >= 3)
        x = &table.columns[0], y = &table.columns[1], z = &table.columns[2];
    if (!x || !y || !z)
        return input_error("has no columns x, y and z", where,
                           "a cloud's points need x, y and z in millimetres");
    const auto* nx = column(table, {"nx", "normal_x"});
    const auto* ny = column(table, {"ny", "normal_y"});
    const auto* nz = column(table, {"nz", "normal_z"});
    const auto* tx = column(table, {"towards_x"});
    const auto* ty = column(table, {"towards_y"});
    const auto* tz = column(table, {"towards_z"});
    const auto* sigma = column(table, {"sigma_mm"});
    const auto unit_vector = [](double a, double b, double c) {
        const Eigen::Vector3d v(a, b, c);
        const double length = v.norm();
        return std::isfinite(length) && length > 1e-6 ? Eigen::Vector3f((v / length).cast<float>())
                                                      : Eigen::Vector3f(Eigen::Vector3f::Zero());
    };
    Cloud cloud;
    cloud.points.reserve(table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i) {
        const Eigen::Vector3d p((*x)[i], (*y)[i], (*z)[i]);
        if (!p.allFinite()) continue;
        if (p.cwiseAbs().maxCoeff() > 1e6)
            return input_error("the scan has a point that is not finite or beyond 1 km", table.at(where, i),
                               "give millimetres");
        cloud.points.push_back(p);
        if (nx && ny && nz) cloud.normals.push_back(unit_vector((*nx)[i], (*ny)[i], (*nz)[i]));
        if (tx && ty && tz) cloud.towards.push_back(unit_vector((*tx)[i], (*ty)[i], (*tz)[i]));
        if (sigma)
            cloud.sigma_mm.push_back(
                std::isfinite((*sigma)[i]) && (*sigma)[i] > 0 ? static_cast<float>((*sigma)[i]) : 0.0F);
    }
    if (cloud.empty()) return input_error("holds no points", where);
    SEAM_OK(set_scale(cloud, unit, where));
    return cloud;
}

Expected<Cloud> read_cloud(const std::filesystem::path& path, const std::string& unit) {
    SEAM_TRY(const auto bytes, read_text_file(path, kCloudFileLimit));
    return parse_cloud(bytes, path.string(), unit);
}

std::string cloud_ply(const Cloud& cloud, std::string_view frame) {
    std::string head = fmt::format("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n",
                                   frame, cloud.size());
    for (const Column& c : columns_of(cloud))
        for (int k = 0; k < c.count; ++k)
            head += fmt::format("property float {}\n", c.names[static_cast<std::size_t>(k)]);
    return binary(head + "end_header\n", cloud);
}

std::string cloud_pcd(const Cloud& cloud, std::string_view frame) {
    std::string fields, sizes, types, counts;
    for (const Column& c : columns_of(cloud))
        for (int k = 0; k < c.count; ++k) {
            std::string name = c.names[static_cast<std::size_t>(k)];
            if (name.size() == 2 && name[0] == 'n') name = fmt::format("normal_{}", name[1]);  // PCL's
            fields += " " + name;
            sizes += " 4";
            types += " F";
            counts += " 1";
        }
    return binary(
        fmt::format(
            "# .PCD v0.7 - {0}\nVERSION 0.7\nFIELDS{1}\nSIZE{2}\nTYPE{3}\nCOUNT{4}\nWIDTH {5}\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {5}\nDATA binary\n",
            frame, fields, sizes, types, counts, cloud.size()),
        cloud);
}

std::string cloud_csv(const Cloud& cloud) {
    std::string text = "x_mm,y_mm,z_mm";
    if (cloud.has_normals()) text += ",nx,ny,nz";
    if (cloud.has_towards()) text += ",towards_x,towards_y,towards_z";
    if (cloud.has_sigma()) text += ",sigma_mm";
    text += '\n';
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        bool first = true;
        each_number(cloud, i, [&](auto value) {
            if (!first) text += ',';
            fmt::format_to(std::back_inserter(text), "{:.7g}", static_cast<double>(value));
            first = false;
        });
        text += '\n';
    }
    return text;
}

Expected<void> write_cloud(const std::filesystem::path& path, const Cloud& cloud, std::string_view frame) {
    const std::string ending = path.extension().string();
    if (ending == ".ply") return write_text_file(path, cloud_ply(cloud, frame));
    if (ending == ".pcd") return write_text_file(path, cloud_pcd(cloud, frame));
    if (ending == ".csv") return write_text_file(path, cloud_csv(cloud));
    return usage_error("a cloud is written as .ply, .pcd or .csv", path.string(), "name the file so");
}

}  // namespace seamwright
