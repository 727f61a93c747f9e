# What limn-bench says of two revisions' files: as fast, slower, a peer slower, a row in one only, nothing in common, not such a file.
file(MAKE_DIRECTORY ${FOLDER})

function(document file ours peer)
  file(WRITE ${FOLDER}/${file} "{\"rows\": [
    {\"kind\": \"march\", \"object\": \"sphere\", \"voxels\": 256, \"threads\": 2, \"contestant\": \"limn.central\", \"name\": \"limn level_set\", \"median_ms\": ${ours}},
    {\"kind\": \"march\", \"object\": \"sphere\", \"voxels\": 256, \"threads\": 2, \"contestant\": \"openvdb\", \"name\": \"OpenVDB\", \"median_ms\": ${peer}}]}")
endfunction()

function(expect code text before after)
  execute_process(COMMAND ${BENCH} --against ${before} ${after} ${ARGN} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE result OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT result EQUAL code OR NOT out MATCHES "${text}")
    message(FATAL_ERROR "${before} ${after} ${ARGN}: exit ${result}, expected ${code} and '${text}', got:\n${out}")
  endif()
endfunction()

document(a.json 20.0 400.0)
document(slow_peer.json 20.5 900.0)
document(slow.json 30.0 400.0)
document(odd.json 90.0 400.0)
# The first revisions named their rows otherwise.
file(WRITE ${FOLDER}/first.json "{\"rows\": [{\"name\": \"march\", \"object\": \"sphere\", \"voxels\": 256, \"threads\": 2, \"contestant\": \"limn level_set\", \"median_ms\": 60.0},
  {\"name\": \"march\", \"object\": \"torus\", \"voxels\": 256, \"threads\": 2, \"contestant\": \"limn level_set\", \"median_ms\": 60.0}]}")
file(WRITE ${FOLDER}/empty.json "{\"rows\": []}")
file(WRITE ${FOLDER}/broken.json "{")

expect(0 "none of limn's 1 rows" a.json a.json)
expect(0 "none of limn's 1 rows" a.json slow_peer.json)
expect(1 "SLOWER" a.json slow.json)
expect(0 "none of limn's 1 rows" slow.json a.json)
expect(0 "none of limn's 1 rows" a.json slow.json --limit 1.6)
# One odd round of three does not count.
expect(0 "none of limn's 1 rows" a.json,a.json,a.json a.json,odd.json,a.json)
expect(1 "1 of limn's 1 rows" a.json,a.json,a.json slow.json,odd.json,a.json)
expect(0 "only in one revision: sphere 256 2 thr: OpenVDB" first.json a.json)
expect(2 "no row of limn's" empty.json empty.json)
expect(2 "not as many files" a.json,a.json a.json)
expect(2 "holds no rows" broken.json a.json)
expect(2 "cannot be read" a.json missing.json)
