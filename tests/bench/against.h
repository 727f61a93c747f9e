#pragma once
// Two revisions on one machine: which of limn's rows got slower.

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

namespace limn::bench {

/// `before` and `after` are lists FILE,FILE,... of documents that limn-bench wrote, run by turns: the i-th files of both make a round. A
/// contestant's ratio is the median over the rounds of its time after over its time before. Rows that only one revision has are named.
/// Rows of limn whose ratio is above `limit` are in the result's "slower". Throws InputError.
nlohmann::json compare_revisions(const std::string& before, const std::string& after, double limit, std::FILE* table);

}  // namespace limn::bench
