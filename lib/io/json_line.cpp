// json_line.cpp: builds JSON from the parser's events; the library's own callback parser needs quadratic time.
#include "io/json_line.h"

#include <vector>

#include "core/types.h"
#include "io/json_values.h"

namespace kiln::io {

namespace {


class Builder final : public nlohmann::json_sax<Json> {
   public:
    explicit Builder(const std::string& place) : place_(place) {}

    Json take() { return std::move(root_); }

    bool null() override { return put(nullptr); }
    bool boolean(bool value) override { return put(value); }
    bool number_integer(number_integer_t value) override { return put(value); }
    bool number_unsigned(number_unsigned_t value) override { return put(value); }
    bool number_float(number_float_t value, const string_t&) override { return put(value); }
    bool string(string_t& value) override { return put(std::move(value)); }
    bool binary(binary_t&) override { return false; }  // has no form in JSON text
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override {
        Json& object = *open_.back();
        if (object.size() == max_keys) fail("has an object of more than " + std::to_string(max_keys) + " keys");
        const auto [entry, fresh] = object.emplace(name, nullptr);
        if (!fresh) fail("key '" + clipped(name) + "' stands twice");
        named_ = &*entry;
        return true;
    }

    bool parse_error(std::size_t byte, const std::string&, const nlohmann::detail::exception& error) override {
        const bool too_large = dynamic_cast<const Json::out_of_range*>(&error) != nullptr;
        const std::string cause = too_large ? "has a number too large for a double" : "is not a line of JSON";
        fail(cause + " (byte " + std::to_string(byte) + ")");
    }

   private:
    [[noreturn]] void fail(const std::string& cause) const { throw Error(place_ + ": " + cause); }

    Json* insert(Json value) {
        if (open_.empty()) return &(root_ = std::move(value));
        if (open_.back()->is_object()) return &(*named_ = std::move(value));
        open_.back()->push_back(std::move(value));
        return &open_.back()->back();
    }

    template <typename Value>
    bool put(Value&& value) {
        insert(Json(std::forward<Value>(value)));
        return true;
    }

    bool open(Json container) {
        if (open_.size() == deepest_nesting) fail("is nested deeper than " + std::to_string(deepest_nesting) + " levels");
        open_.push_back(insert(std::move(container)));
        return true;
    }

    bool close() {
        open_.pop_back();
        return true;
    }

    const std::string& place_;
    Json root_;
    std::vector<Json*> open_;  // the containers around the next value; none of them grows while an inner one is open
    Json* named_ = nullptr;    // where the value of the last key goes
};

}  // namespace

Json parse_line(std::string_view line, const std::string& place) {
    if (const std::size_t zero = line.find('\0'); zero != std::string_view::npos)  // the parser would take it for the end
        throw Error(place + ": is not a line of JSON (byte " + std::to_string(zero + 1) + ")");
    Builder builder(place);
    Json::sax_parse(line.begin(), line.end(), &builder);
    return builder.take();
}

}  // namespace kiln::io
