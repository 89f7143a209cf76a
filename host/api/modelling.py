"""Fits in their parts: readers of files, features, training sets, kinds of model, cross-validation.

>>> from springpot.modelling import gl_taps
>>> gl_taps(0.5, 4, dt_s=1.0)
array([ 1.    , -0.5   , -0.125 , -0.0625])
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.codegen.forest.leaves import (
        level_order as level_order,
        quantisation_over as quantisation_over,
        rounded as rounded,
    )
    from springpot.codegen.model.features import (
        Features as Features,
        FirBank as FirBank,
    )
    from springpot.codegen.model.model import (
        TrainedRange as TrainedRange,
    )
    from springpot.codegen.model.model_file import (
        model_bytes as model_bytes,
        model_hash as model_hash,
        register_part as register_part,
    )
    from springpot.codegen.model.passive import Hammerstein as Hammerstein
    from springpot.codegen.model.regressors import (
        Forest as Forest,
        Quantisation as Quantisation,
        Regressor as Regressor,
    )
    from springpot.host.wings.evidence.splits import (
        Split as Split,
        cross_validated_rmse_n as cross_validated_rmse_n,
        holdout as holdout,
        recording_splits as recording_splits,
    )
    from springpot.trainer.features.fast_fir import fast_fir_bank as fast_fir_bank
    from springpot.trainer.features.fractional import (
        fir_derivatives as fir_derivatives,
        gl_taps as gl_taps,
        recursive_bank as recursive_bank,
    )
    from springpot.trainer.features.values import (
        feature_values as feature_values,
        highpass as highpass,
    )
    from springpot.trainer.kinds import (
        KINDS as KINDS,
        Kind as Kind,
        fit_kind as fit_kind,
        fit_model as fit_model,
    )
    from springpot.trainer.models.compatibility import (
        require_compatible as require_compatible,
    )
    from springpot.trainer.models.contact import contact_of as contact_of, depth_m as depth_m
    from springpot.trainer.models.fit import PAPER_CENTERS as PAPER_CENTERS, assemble as assemble
    from springpot.trainer.models.folds import (
        Folds as Folds,
        fold_families as fold_families,
        geometric_mean as geometric_mean,
        recording_folds as recording_folds,
        repeats_apart as repeats_apart,
    )
    from springpot.trainer.models.forests import (
        depth_scale as depth_scale,
        ensemble_ir as ensemble_ir,
        fit_forest as fit_forest,
        random_forest as random_forest,
    )
    from springpot.trainer.models.limited import (
        extrapolation as extrapolation,
        limited_n as limited_n,
    )
    from springpot.trainer.models.passive.passive_fit import fit_passive as fit_passive
    from springpot.trainer.models.passive.passive_force import model_along as model_along
    from springpot.trainer.models.predict import (
        predict_each_n as predict_each_n,
        regressor_force as regressor_force,
    )
    from springpot.trainer.models.radial import (
        fit_rbf as fit_rbf,
    )
    from springpot.trainer.models.rf_fd import (
        MAX_TAPS as MAX_TAPS,
        PAPER_ORDERS as PAPER_ORDERS,
        PAPER_TAPS as PAPER_TAPS,
        fractional_features as fractional_features,
        window_samples as window_samples,
    )
    from springpot.trainer.models.training_set import (
        TrainingSet as TrainingSet,
        training_set as training_set,
    )
    from springpot.trainer.recordings.contact_point import (
        ContactPoint as ContactPoint,
        find_contact as find_contact,
    )
    from springpot.trainer.recordings.formats.column_map import (
        MAP_EXAMPLE as MAP_EXAMPLE,
        Column as Column,
        ColumnMap as ColumnMap,
        guess_column as guess_column,
        split_unit as split_unit,
        stated_hz as stated_hz,
        stated_rate_hz as stated_rate_hz,
    )
    from springpot.trainer.recordings.formats.csv.csv_missing import (
        wanted_columns as wanted_columns,
    )
    from springpot.trainer.recordings.formats.csv.csv_text import read_csv as read_csv
    from springpot.trainer.recordings.formats.csv.csv_units import pair_columns as pair_columns
    from springpot.trainer.recordings.formats.csv.decimals import is_number as is_number
    from springpot.trainer.recordings.formats.file_format import (
        FileFormat as FileFormat,
        FileRequest as FileRequest,
    )
    from springpot.trainer.recordings.formats.missing_samples import GAP_STEPS as GAP_STEPS
    from springpot.trainer.recordings.formats.raw_channels import RawChannels as RawChannels
    from springpot.trainer.recordings.formats.sampling import MIN_ROWS as MIN_ROWS
    from springpot.trainer.recordings.formats.units import (
        FRAME_NAME as FRAME_NAME,
        Quantity as Quantity,
        Unit as Unit,
        choose_unit as choose_unit,
    )
    from springpot.trainer.recordings.places import require_one_place as require_one_place
    from springpot.trainer.recordings.quality.cycles import find_cycles as find_cycles
    from springpot.trainer.recordings.quality.finding import Finding as Finding, warning as warning
    from springpot.trainer.recordings.quality.motion import find_strokes as find_strokes
    from springpot.trainer.recordings.quality.noise_floor import (
        find_noise_floor as find_noise_floor,
        sensor_noise_n as sensor_noise_n,
    )
    from springpot.trainer.recordings.quality.signs import (
        require_signs as require_signs,
    )
    from springpot.trainer.recordings.quality.spikes import (
        hold_spikes as hold_spikes,
    )
    from springpot.trainer.recordings.reader_limits import (
        read_apart as read_apart,
        require_unpacked as require_unpacked,
        run_reader as run_reader,
    )
    from springpot.trainer.recordings.recording import (
        FRAME_SOURCE as FRAME_SOURCE,
        SIGN_RULE as SIGN_RULE,
        Zero as Zero,
        zero_word as zero_word,
    )
    from springpot.trainer.recordings.recording_file import (
        Recordings as Recordings,
        given_recordings as given_recordings,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
