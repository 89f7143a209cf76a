/* Of the scene that stands in for an emitted one. */
#define SP_METADATA_HASH {{0}}
#define SP_METADATA_DT_S 1e-3f
#define SP_METADATA_MAX_N 10.0f
#define SP_METADATA_WATCHDOG_S 0.02f
